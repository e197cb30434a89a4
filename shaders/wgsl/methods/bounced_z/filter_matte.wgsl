// What neighbouring pixels' rays say of a matte surface.

#import methods/bounced_z/filter
#import shared/bounced_matte
#import shared/surface_valid
#constant CHANNELS = 1
