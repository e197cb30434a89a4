// What rays meet along directions that glossy surfaces reflect to the eye.

#import shared/bounced_trace
#import shared/bounced_glossy
#import shared/gloss
