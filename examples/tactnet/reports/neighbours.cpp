#include "reports/neighbours.hpp"

#include "console.hpp"
#include "reports/report.hpp"

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <set>

namespace {

using tactnet::neighbour_report;

std::string name_of(const compared_images& of, std::size_t image) {
    return printable(of.paths[image].lexically_relative(of.root).string());
}

/// "the nearest image of the same class is … for 251 of 1 100 images (45 by chance), such as a and b".
std::string counts_text(const compared_images& of, const neighbour_report& found, const std::string& related,
                        const char* images) {
    std::string text =
        fmt::format("the nearest image of the same class is {} for {} of {} {} ({:.0f} by chance)", related,
                    grouped(found.related.size()), grouped(found.tested), images, found.expected);
    std::set<std::pair<std::size_t, std::size_t>> shown; // images that are each other's nearest, once
    for (const auto& [image, nearest, distance] : found.related)
        if (shown.size() < 3 && shown.insert(std::minmax(image, nearest)).second)
            text += fmt::format("{}{} and {}", shown.size() == 1 ? ", such as " : "; ", name_of(of, image),
                                name_of(of, nearest));
    return text;
}

neighbour_report compare(const compared_images& of, std::span<const std::size_t> groups,
                         std::span<const std::size_t> test, std::span<const std::size_t> training) {
    return tactnet::compare_neighbours(of.images, of.size, groups, test, training);
}

constexpr const char* after_another = "the one recorded before or after it";
constexpr const char* page_of_tests = "docs/verify/honest_tests.md";

/// Of numbers in file names that are groups, the one whose groups the nearest images are of most often.
std::string pattern_text(const compared_images& of, std::span<const std::size_t> test,
                         std::span<const std::size_t> training, double recognised) {
    std::string best;
    double lowest = recognised - 0.01; // what differs by less says nothing
    for (const name_pattern& candidate : patterns_of_names(of.paths))
        if (const neighbour_report found = compare(of, candidate.groups, test, training);
            found.too_easy() && found.without_related < lowest) {
            lowest = found.without_related;
            best = fmt::format(
                "for images of the same --group '{}', {}; without these, the nearest image has the "
                "right class for {:.1f} %: if the pattern names people, objects or sessions, test "
                "by it\n",
                candidate.pattern, counts_text(of, found, "of the same group", "images"),
                100 * found.without_related);
        }
    return best;
}

} // namespace

std::string neighbours_text(const compared_images& of) {
    const std::vector<std::size_t> all = tactnet::all_samples(of.images.labels.size());
    const neighbour_report found = compare(of, of.groups, all, all);
    if (!found.too_easy())
        return {};
    const bool groups = !of.groups.empty();
    return fmt::format("near-duplicates: {}. A random split overstates: the nearest image of all has the "
                       "right class for "
                       "{:.1f} %, and for {:.1f} % without {}. Test with {} ({})\n",
                       counts_text(of, found, groups ? "of the same group" : after_another, "images"),
                       100 * found.recognised, 100 * found.without_related,
                       groups ? "its group" : "the tenth of each class recorded before and after",
                       groups ? "--split grouped or leave-one-group-out" : "--split blocked, or by --group",
                       page_of_tests) +
           (groups ? "" : pattern_text(of, all, all, found.recognised));
}

std::string neighbours_text(const compared_images& of, std::span<const std::size_t> test,
                            std::span<const std::size_t> training) {
    const neighbour_report by_order = compare(of, {}, test, training);
    const neighbour_report by_group =
        of.groups.empty() ? neighbour_report{} : compare(of, of.groups, test, training);
    const neighbour_report& found = by_group.too_easy() ? by_group : by_order;
    const std::string by_name =
        of.groups.empty() ? pattern_text(of, test, training, by_order.recognised) : "";
    if (!found.too_easy())
        return by_name.empty() ? "" : "warning: near-duplicates in test and training: " + by_name;
    return fmt::format(
               "warning: near-duplicates in test and training: {}. The nearest training image has the right "
               "class "
               "for {:.1f} % of the test, and for {:.1f} % without {}: new recordings are harder than this "
               "test ({})\n",
               counts_text(of, found, by_group.too_easy() ? "of the same group" : after_another,
                           "test images"),
               100 * found.recognised, 100 * found.without_related,
               by_group.too_easy() ? "its group" : "the tenth of each class recorded before and after",
               page_of_tests) +
           by_name;
}

void tell_neighbours(const image_data& data, const tactnet::data_split& split) {
    const tactnet::image_set& set = data.images;
    if (!split.test.empty())
        show(neighbours_text({{set.pixels, set.labels, set.classes.size()},
                              {set.rows, set.columns},
                              data.groups,
                              set.paths,
                              data.root},
                             split.test, split.training));
}
