// What of a white sky a pixel's rays see past surfels.

#import shared/bounced_arrive
#import shared/bounced_sky
