// Light of the lamps that the medium in cells scatters.

#import shared/lpv_begin
#import shared/lpv_lamps_only
