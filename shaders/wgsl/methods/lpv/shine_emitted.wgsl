// Light that surfels emit.

#import methods/lpv/shine
#import shared/lpv_emits
