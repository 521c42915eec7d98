#pragma once

// The pictures of a study, drawn by gnuplot: as PNG beside the page, and as SVG in it, where the pointer asks
// what a point is (gnuplot_svg.showHypertext, which the page has).

#include "study/rows.hpp"
#include "study/times/peers.hpp"

#include <filesystem>
#include <string>
#include <vector>

struct study_picture {
    std::string name;    ///< of the file, without its ending
    std::string caption; ///< what it shows, a sentence
    std::string script;  ///< of gnuplot, without a terminal
};

/// Those that the rows have something for. Peers are drawn where a row has their network: its highest
/// accuracy at their time.
std::vector<study_picture> study_pictures(const std::vector<study_row>& rows,
                                          const std::vector<peer_time>& peers = {});

/// Writes a picture into a folder as PNG, and gives it as SVG: nothing where it cannot be drawn, which is
/// told.
std::string draw_study_picture(const study_picture& picture, const std::filesystem::path& folder);
