#include <tactnet/runtime/folds.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace tactnet;

std::vector<std::size_t> digits(std::string_view text) {
    std::vector<std::size_t> numbers;
    for (const char c : text)
        numbers.push_back(static_cast<std::size_t>(c - '0'));
    return numbers;
}

constexpr std::string_view labels = "2010001121121200012021222201210211202010", few = "551911999951111115",
                           groups = "5461564460012450055611155234433000022305",
                           unlike = "49999922277711100000"; // sizes 1, 5, 3, 3, 3, 5

/// What scikit-learn 1.2.1 returns: StratifiedKFold, GroupKFold, and with 0 folds LeaveOneGroupOut.
struct folds_of_scikit_learn {
    std::string_view input, found;
    std::size_t folds;
    bool by_group = true;
};
constexpr folds_of_scikit_learn known[] = {
    {labels, "0000000000000000010101011111111111111111", 2, false},
    {labels, "0000000000001011110111111121222222222222", 3, false},
    {labels, "0000010101202111221213222333333344444444", 5, false},
    {few, "000000011110011111", 2, false},
    {few, "000000112211112222", 3, false},
    {groups, "1100101100000110011000011011111000000101", 2},
    {groups, "1212112210022210011122211202200000022001", 3},
    {groups, "1243142240036210011433311652255000066501", 7},
    {unlike, "10000011100000011111", 2},
    {unlike, "10000022222200011111", 3},
    {unlike, "50000033322244411111", 6},
    {unlike, "35555522244411100000", 0},
    {groups, groups, 0},
};

} // namespace

TEST_CASE("folds: are scikit-learn's") {
    for (const folds_of_scikit_learn& of : known) {
        CAPTURE(of.input);
        CAPTURE(of.folds);
        const auto input = digits(of.input);
        const auto found = !of.by_group    ? stratified_folds(input, of.folds)
                           : of.folds == 0 ? one_group_folds(input)
                                           : group_folds(input, of.folds);
        CHECK(found == digits(of.found));
    }
}

TEST_CASE("folds: too few or too many are refused") {
    const auto refused = [](const auto& call, std::string_view sentence) {
        try {
            (void)call();
            FAIL("expected an error");
        } catch (const std::invalid_argument& error) {
            CHECK(std::string_view(error.what()) == sentence);
        }
    };
    refused([] { return stratified_folds(digits("012"), 1); },
            "folds: expected 2 to 3, the number of samples, found 1");
    refused([] { return group_folds(digits("01100"), 3); },
            "folds: expected 2 to 2, the number of groups, found 3");
    refused([] { return one_group_folds(digits("77")); }, "folds: expected two groups or more, found 1");
}
