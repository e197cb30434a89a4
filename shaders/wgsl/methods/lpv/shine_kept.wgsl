// Light that surfels give back of what they kept.

#import methods/lpv/shine
#import shared/lpv_gives_back
#constant HEIGHT = 8
