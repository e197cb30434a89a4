// What of a white sky a pixel's rays see past surfels.

#import methods/bounced_z/arrive
#import shared/bounced_sky
