// expect: static.assert.*the sentence
// at-most: 1
// characters: 20
static_assert(false, "the sentence");
