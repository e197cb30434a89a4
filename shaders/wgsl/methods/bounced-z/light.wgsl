// What light surfels send along a pixel's rays.

#import shared/bounced_arrive
#import shared/bounced_light
