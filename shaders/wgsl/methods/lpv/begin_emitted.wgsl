// Light of the lamps and of surfaces that the medium in cells scatters.

#import shared/lpv_begin
#import shared/lpv_emitted
