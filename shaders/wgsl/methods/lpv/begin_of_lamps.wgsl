// Light of the lamps that the medium in cells scatters.

#import methods/lpv/begin
#import shared/lpv_lamps_only
