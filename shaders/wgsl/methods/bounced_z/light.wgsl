// What light surfels send along a pixel's rays.

#import methods/bounced_z/arrive
#import shared/bounced_light
