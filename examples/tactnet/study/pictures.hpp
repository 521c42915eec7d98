#pragma once

// The pictures of a study, each as CSV and PNG next to the page.

#include "files/output_files.hpp"
#include "study/page.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

struct study_picture {
    std::string name;    ///< of the files, without their ending; and of the script
    std::string caption; ///< what it shows, a sentence
    std::string csv;     ///< its points
    std::vector<std::string> series{};
};

/// Those that the rows have something for.
std::vector<study_picture> study_pictures(const std::vector<study_row>& rows);

/// Draws them in a folder. Returns those that could be drawn.
std::vector<page_picture> draw_study_pictures(const std::vector<study_row>& rows,
                                              const std::filesystem::path& folder);

/// Checks the inputs of trainings and all that they leave in a folder of results: `files`, `pictures` by
/// their stems, those of a study and what every evaluation has. See check_outputs.
void check_study_files(const std::filesystem::path& folder, std::vector<std::string> files,
                       std::set<std::filesystem::path> pictures, const std::vector<named_file>& inputs,
                       const std::filesystem::path& data, const candidate_list& candidates);
