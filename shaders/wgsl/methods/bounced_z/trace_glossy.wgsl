// What rays meet along directions that glossy surfaces reflect to the eye.

#import methods/bounced_z/trace
#import shared/bounced_glossy
#import shared/gloss
