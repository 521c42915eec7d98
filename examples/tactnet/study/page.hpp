#pragma once

// The report of a study: tables, which the terminal shows too, as Markdown for a README and on one HTML page
// that needs no other file.

#include "reports/report.hpp"
#include "study/rows.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

struct study_table {
    std::string name;    ///< in the comments of the Markdown file
    std::string title;   ///< a heading
    std::string caption; ///< what it shows, a sentence
    table_cells cells;   ///< the head alone if there is nothing to show
    bool shaded = false; ///< a matrix of counts
    std::string notes{}; ///< a line for each row that is missing, with the reason
};

/// All methods.
study_table methods_table(const std::vector<study_row>& rows);
/// What else is known of them: other accuracies, times and bytes.
study_table details_table(const std::vector<study_row>& rows);
study_table probabilities_table(const std::vector<study_row>& rows);
study_table decisions_table(const std::vector<study_row>& rows);
/// All tables that have something to show, the methods with which no other is both faster and more accurate
/// first.
std::vector<study_table> study_tables(const std::vector<study_row>& rows);

/// How well each class is recognised.
struct class_rate {
    std::string name;
    std::size_t images = 0;  ///< that show it, over all splits
    double sensitivity = 0;  ///< the share of them that is recognised; NaN without any
    double precision = 0;    ///< the share of what is taken for it that is it; NaN if nothing is
    std::string taken_for{}; ///< most often, where it is not recognised; empty if it always is
    std::size_t times = 0;   ///< how often that was

    /// The lower of both, as far as they are known.
    double worst() const;
};
/// All classes, the worst first.
std::vector<class_rate> class_rates(const study_row& row);

/// What a report is of.
struct report_subject {
    std::string images;  ///< what all was trained and tested on, a sentence
    std::string program; ///< what trained and timed: processor, compiler, version
};

/// Tables between comments that say where each begins and ends, `<!-- study front -->` and
/// `<!-- study front ends -->`, to be copied as they are.
std::string study_markdown(const std::vector<study_row>& rows, const report_subject& of);

/// With pictures as SVG, each after its caption; an empty one is left out.
std::string study_page(const std::vector<study_row>& rows,
                       const std::vector<std::pair<std::string, std::string>>& pictures,
                       const report_subject& of);
