TEST_CASE("shape: the size is rows x columns x channels") {}
// Nothing says of what; the name stands on a line of its own, as it may in a long one.
// clang-format off
TEST_CASE(
    "sizes are multiplied") {}
// clang-format on
// Says it twice.
TEST_CASE("shape: shape: sizes are positive") {}
