#include <tactnet/features.hpp>

#include <vector>

#ifdef CASE_dense_surf_single_tactel
// expect: dense_surf: expected one map of at least 2 x 2 tactels
// at-most: 1
constexpr auto descriptors = tactnet::dense_surf<tactnet::shape{1, 1}>::most;
#endif

#ifdef CASE_descriptors_of_temporary
// expect: would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::dense_surf<tactnet::shape{14, 25, 1}>().descriptors());
}
#endif

#ifdef CASE_words_of_temporary
// expect: would dangle
// at-most: 1
void run() {
    static_cast<void>(tactnet::bag_of_words<2, 3>(std::vector<float>(4)).words());
}
#endif
