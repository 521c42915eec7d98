#pragma once

// Which processor this is, for measurements that are kept.

#include <fstream>
#include <string>

/// What the system calls it; "unknown" where it says nothing.
inline std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "unknown";
}
