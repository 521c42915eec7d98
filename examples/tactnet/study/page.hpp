#pragma once

// The report of a study as a page of Markdown: tables, which the terminal shows too, and pictures, each as
// CSV and PNG next to the page.

#include "files/output_files.hpp"
#include "reports/report.hpp"
#include "study/rows.hpp"

#include <set>

struct study_table {
    std::string name;    ///< in the comments of the page
    std::string title;   ///< a heading
    std::string caption; ///< what it shows, a sentence
    table_cells cells{}; ///< the head alone if there is nothing to show
};

/// All methods.
study_table methods_table(const std::vector<study_row>& rows);
/// What else is known of them: other accuracies, times and bytes.
study_table details_table(const std::vector<study_row>& rows);
study_table probabilities_table(const std::vector<study_row>& rows);

/// A picture in the folder of the page.
struct study_picture {
    std::string name;    ///< of the files, without their ending; and of the script
    std::string caption; ///< what it shows, a sentence
    std::string csv{};   ///< its points
    std::vector<std::string> series{};
};

/// Pictures, and all tables that have something to show, the Pareto front first. Each table is between
/// comments, `<!-- study front -->` and `<!-- study front ends -->`, to be copied as it is.
/// `about`: what all was trained and tested on, and by what: processor, compiler, version.
std::string study_page(const std::vector<study_row>& rows, const std::vector<study_picture>& pictures,
                       const std::string& about);

/// Those that the rows have something for.
std::vector<study_picture> study_pictures(const std::vector<study_row>& rows);

/// Draws them in a folder. Returns those that could be drawn.
std::vector<study_picture> draw_study_pictures(const std::vector<study_row>& rows,
                                               const std::filesystem::path& folder);

/// Checks the inputs of trainings and all that they leave in a folder of results: `files`, `pictures` by
/// their stems, and what every evaluation has. See check_outputs.
void check_study_files(const std::filesystem::path& folder, std::vector<std::string> files,
                       std::set<std::filesystem::path> pictures, const std::vector<named_file>& inputs,
                       const std::filesystem::path& data, const candidate_list& candidates);
