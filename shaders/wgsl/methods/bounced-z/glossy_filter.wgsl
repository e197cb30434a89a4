// What neighbouring pixels' rays say of a glossy surface.

#import shared/bounced_filter
#import shared/bounced_glossy
#import shared/gloss
#constant CHANNELS = 3
