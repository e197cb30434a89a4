// Light that surfels emit.

#import shared/lpv_shine
#import shared/lpv_emits
