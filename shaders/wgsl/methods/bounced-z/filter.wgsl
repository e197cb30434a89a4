// What neighbouring pixels' rays say of a matte surface.

#import shared/bounced_filter
#import shared/bounced_matte
#import shared/surface_valid
#constant CHANNELS = 1
