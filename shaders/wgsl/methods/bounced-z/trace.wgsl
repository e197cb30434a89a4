// What rays of a matte surface meet.

#import shared/bounced_trace
#import shared/bounced_matte
#import shared/surface_valid
