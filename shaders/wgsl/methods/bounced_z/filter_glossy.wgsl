// What neighbouring pixels' rays say of a glossy surface.

#import methods/bounced_z/filter
#import shared/bounced_glossy
#import shared/gloss
#constant CHANNELS = 3
