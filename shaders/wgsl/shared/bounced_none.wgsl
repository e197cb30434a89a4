// What a ray has met that has met nothing.
const NONE = 0xffffffffu;
