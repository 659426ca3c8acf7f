// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/plugin_library.h>

#include <tombolo/base/input/present_headers.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/input/text.h>

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Reports which library ends the program while it is loaded: the code that runs then is not
     * ours, and nothing catches what it throws. */
    class LoadingGuard
    {
    public:
      explicit LoadingGuard(std::string library_path) : former_handler(std::get_terminate())
      {
        static const bool is_registered = std::atexit(&report_exit) == 0;
        (void)is_registered;
        library = std::move(library_path);
        std::set_terminate(&report_exception);
      }

      ~LoadingGuard()
      {
        library.clear();
        std::set_terminate(former_handler);
      }

      LoadingGuard(const LoadingGuard &) = delete;
      LoadingGuard &operator=(const LoadingGuard &) = delete;

    private:
      [[noreturn]] static void leave(const std::string &what)
      {
        std::cerr << "Error: the plug-in library " << library << ' ' << what << std::endl;
        _exit(EXIT_FAILURE);
      }

      static void report_exit()
      {
        if (!library.empty())
          leave("ends the program while it is loaded.");
      }

      [[noreturn]] static void report_exception()
      {
        std::string what = "throws what is no exception while it is loaded.";
        try
        {
          if (const std::exception_ptr thrown = std::current_exception())
            std::rethrow_exception(thrown);
        }
        catch (const std::exception &exception)
        {
          what = std::string("throws an exception while it is loaded: ") + exception.what();
        }
        catch (...)
        {}
        leave(what);
      }

      static inline std::string library; // empty: none is being loaded
      std::terminate_handler former_handler;
    };

    namespace files = std::filesystem;

    /** The directory of the shared object that this code is in. */
    files::path own_directory()
    {
      static const char here = 0;
      Dl_info info;
      return dladdr(&here, &info) != 0 ? files::path(info.dli_fname).parent_path() : files::path();
    }

    /** Whether a file ends before the table of its sections, which is the last in it: the system's
     * loader would crash. */
    bool ends_early(const std::string &content)
    {
      ElfW(Ehdr) header;
      if (content.size() < sizeof header || content.compare(0, SELFMAG, ELFMAG) != 0)
        return false; // the loader says what it is not
      std::memcpy(&header, content.data(), sizeof header);
      return content.size() < header.e_shoff + std::size_t(header.e_shnum) * header.e_shentsize;
    }

    /** The headers that a library was built with (cmake/plugin_headers.cc), by its content; empty
     * if it has none. */
    std::string headers_of(const std::string &content)
    {
      const std::string mark = "tombolo plug-in with headers ";
      const std::size_t position = content.find(mark);
      return position == std::string::npos
                 ? ""
                 : content.substr(position + mark.size(), present_headers().size());
    }

    /** Loads one library; returns what is wrong, or nothing. */
    std::string load(const std::string &name, const std::string &parameter_file)
    {
      std::error_code error;
      const files::path beside_file = files::path(parameter_file).parent_path() / name;
      std::vector<files::path> candidates{beside_file};
      for (const files::path &other : {files::path(name), own_directory() / name})
        if (std::find(candidates.begin(), candidates.end(), other) == candidates.end())
          candidates.push_back(other);
      const auto path = std::find_if(candidates.begin(), candidates.end(),
                                     [&](const files::path &candidate)
                                     { return files::is_regular_file(candidate, error); });
      if (path == candidates.end())
      {
        std::string paths;
        for (const files::path &candidate : candidates)
          paths += (paths.empty() ? "" : ", nor ") + in_quotes(candidate.string());
        return "there is no library " + paths + ".";
      }
      // An absolute path: dlopen would search a bare name in the directories of the system.
      const std::string absolute = files::absolute(*path, error).string();
      std::ifstream file(absolute, std::ios::binary);
      const std::string content{std::istreambuf_iterator<char>(file), {}};
      if (ends_early(content))
        return "the library ends early: it was not built or copied to its end.";
      const std::string headers = headers_of(content);
      if (!headers.empty() && headers != present_headers())
        return "the library was built with other headers of Tombolo than this program, with which "
               "it "
               "would fail; build it again.";
      const LoadingGuard guard(absolute);
      if (dlopen(absolute.c_str(), RTLD_NOW | RTLD_GLOBAL) == nullptr)
      {
        const char *const message = dlerror();
        return "the library cannot be loaded: " +
               std::string(message != nullptr ? message : "unknown reason") + ".";
      }
      return internal::release_registration_problems();
    }
  } // namespace

  void load_plugin_libraries(const Parameters &parameters, const MPI_Comm communicator,
                             const std::string &entry)
  {
    for (const auto &name : parameters.raw_list(entry))
      if (const std::string problem = first_text(communicator, load(name, parameters.file_name()));
          !problem.empty())
        parameters.fail(entry, problem);
  }
} // namespace tombolo
