#include "program_arguments.hpp"

#if defined(_WIN32)
#include <clocale>
#include <cstdio>
// Its macros go no further than this file; the others need it before them.
#include <windows.h>
//
#include <fcntl.h>
#include <io.h>
#include <shellapi.h>
#endif

program_arguments::program_arguments(int count, [[maybe_unused]] char** words) {
#if defined(_WIN32)
    for (std::FILE* const stream : {stdin, stdout})
        static_cast<void>(::_setmode(::_fileno(stream), _O_BINARY));
    static_cast<void>(::SetConsoleOutputCP(CP_UTF8));
    static_cast<void>(std::setlocale(LC_CTYPE, ".UTF-8")); // the old run-time library has none
    if (wchar_t** const wide = ::CommandLineToArgvW(::GetCommandLineW(), &count); wide != nullptr) {
        for (int i = 0; i < count; ++i) {
            const auto convert = [&](char* to, int size) {
                return ::WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, to, size, nullptr, nullptr);
            };
            std::string& text = texts_.emplace_back(static_cast<std::size_t>(convert(nullptr, 0)), '\0');
            convert(text.data(), static_cast<int>(text.size()));
        }
        ::LocalFree(wide);
    }
#else
    texts_.assign(words, words + count);
#endif
    for (std::size_t i = 1; i < texts_.size(); ++i)
        pointers_.push_back(texts_[i].c_str());
}
