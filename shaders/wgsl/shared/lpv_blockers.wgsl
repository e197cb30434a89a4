// Sums of what surfaces cover, in fixed point, so that their order does not matter: of each cube 13 of links
// and four of colours.

const BLOCKER_WORDS = 17u;
// A share of 1. The smallest surfels cover a hundredth of that; 65,536 fit one upon the other.
const BLOCKER_ONE = 65536.0;
