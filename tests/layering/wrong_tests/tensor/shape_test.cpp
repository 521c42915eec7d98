TEST_CASE("shape: the size is rows x columns x channels") {}
// Nothing says of what.
TEST_CASE(
    "sizes are multiplied") {}
// Says it twice.
TEST_CASE("shape: shape: sizes are positive") {}
