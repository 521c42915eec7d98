#include "reports/classes.hpp"

#include "console.hpp"

#include <tactnet/text/message.hpp>

#include <cmath>

namespace {

/// Nothing is known of a class without images: null for NaN.
std::vector<nlohmann::ordered_json> class_rows(const tactnet::confusion_matrix& confusion,
                                               const std::vector<std::string>& classes) {
    std::vector<nlohmann::ordered_json> rows;
    for (std::size_t c = 0; c < classes.size(); ++c)
        rows.push_back({{"class", printable(classes[c])},
                        {"images", confusion.samples(c)},
                        {"right", confusion.count(c, c)},
                        {"recall", confusion.recall(c)},
                        {"precision", confusion.precision(c)},
                        {"f1", confusion.f1(c)}});
    return rows;
}

std::string percent(double share) {
    return std::isfinite(share) ? fmt::format("{:.1f}", 100 * share) : "";
}

} // namespace

table_cells class_table(const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes) {
    table_cells cells{{"class", "images", "right", "recall, %", "precision, %", "F1, %"}};
    for (std::size_t c = 0; c < classes.size(); ++c)
        cells.push_back({printable(classes[c]), grouped(confusion.samples(c)), grouped(confusion.count(c, c)),
                         percent(confusion.recall(c)), percent(confusion.precision(c)),
                         percent(confusion.f1(c))});
    cells.push_back({"all, means", grouped(confusion.total()), grouped(confusion.correct()),
                     percent(confusion.balanced_accuracy()), "", percent(confusion.macro_f1())});
    return cells;
}

void write_class_report(const std::filesystem::path& stem, const tactnet::confusion_matrix& confusion,
                        const std::vector<std::string>& classes) {
    write_lines(stem, class_rows(confusion, classes));
}

std::string predictions_csv(const image_data& data, std::span<const std::size_t> images,
                            const tactnet::evaluation& result, double temperature,
                            const nlohmann::ordered_json& first) {
    const std::vector<std::string>& classes = data.images.classes;
    std::vector<nlohmann::ordered_json> rows;
    for (std::size_t i = 0; i < images.size(); ++i) {
        nlohmann::ordered_json& row = rows.emplace_back(first);
        row["path"] = data.name(images[i]);
        row["group"] = data.groups.empty() ? "" : printable(data.group_names[data.groups[images[i]]]);
        row["label"] = printable(classes[data.images.labels[images[i]]]);
        row["prediction"] = printable(classes[result.recognised[i]]);
        if (result.logits.empty())
            continue;
        const auto logits = std::span(result.logits).subspan(i * classes.size(), classes.size());
        const double largest = *std::ranges::max_element(logits);
        double sum = 0;
        for (const float logit : logits)
            sum += std::exp((logit - largest) / temperature);
        for (std::size_t c = 0; c < classes.size(); ++c)
            row["p " + printable(classes[c])] = std::exp((logits[c] - largest) / temperature) / sum;
    }
    return csv_of(rows);
}
