// What rays of a matte surface meet.

#import methods/bounced_z/trace
#import shared/bounced_matte
#import shared/surface_valid
