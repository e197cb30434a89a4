// Light that surfels give back of what they kept.

#import shared/lpv_shine
#import shared/lpv_gives_back
#constant HEIGHT = 8
