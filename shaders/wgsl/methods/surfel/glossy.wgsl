// Light of a level that glossy surfaces reflect.

#import methods/surfel/splat
#import shared/surfel_colour
#import shared/surfel_glossy
