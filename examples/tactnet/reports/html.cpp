#include "reports/html.hpp"

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text)
        result += c == '&'   ? std::string("&amp;")
                  : c == '<' ? std::string("&lt;")
                  : c == '>' ? std::string("&gt;")
                  : c == '"' ? std::string("&quot;")
                             : std::string(1, c);
    return result;
}
