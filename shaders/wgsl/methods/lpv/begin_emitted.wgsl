// Light of the lamps and of surfaces that the medium in cells scatters.

#import methods/lpv/begin
#import shared/lpv_emitted
