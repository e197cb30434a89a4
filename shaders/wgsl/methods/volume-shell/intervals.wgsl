// The transmittance interval map, with samples in full floats.

#import shared/intervals
#import shared/intervals_encode_wide
