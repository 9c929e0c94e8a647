#pragma once

#include <functional>
#include <string>

namespace kinship::experiments {

/// Runs `work` in a process of its own, which writes lines; the caller reads them as they come.
/// Whatever happens to that process, the caller goes on; what it prints on standard output is lost.
/// \param work     called in the child with a function that writes one line (without its end). What
///                 it throws ends the child, with a last line on standard error.
/// \param on_line  called in the caller.
/// \return         empty if the child ended well, else how it ended ("signal 11").
/// \throws Failure(Unavailable) if there is no process to be had.
std::string run_apart(
    const std::function<void(const std::function<void(const std::string&)>&)>& work,
    const std::function<void(const std::string&)>& on_line);

}  // namespace kinship::experiments
