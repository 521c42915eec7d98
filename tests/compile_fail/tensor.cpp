#include <tactnet/tensor.hpp>

#include <vector>

#ifdef CASE_try_view_of_temporary
// expect: borrowed_range
// at-most: 1
void run() {
    static_cast<void>(tactnet::try_view<tactnet::shape{2, 3}>(std::vector<float>(6)));
}
#endif

#ifdef CASE_view_of_temporary
// expect: would dangle
// at-most: 1
using map = tactnet::tensor<float, tactnet::shape{2, 3}>;

void run() {
    static_cast<void>(map().view());
}
#endif
