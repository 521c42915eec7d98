#pragma once

// The tables of a study as Markdown, for a README.

#include "study/rows.hpp"

#include <string>
#include <vector>

/// Two tables between comments that say where each begins and ends, `<!-- study front -->` and
/// `<!-- study methods -->`, to be copied as they are. `images` says what it was made of.
std::string study_markdown(const std::vector<study_row>& rows, const std::string& images);
