#include "proto/dds/binding.hpp"

#include <dds/dds.h>
#include <dlfcn.h>
#include <elf.h>
#include <link.h>

#include <cstdint>
#include <string_view>

namespace kinship::dds {
namespace {

/// The dynamic linker's data of a loaded library, as far as they tell which functions it calls.
struct CalledFunctions {
  std::uintptr_t base = 0;
  const ElfW(Sym) * symbols = nullptr;
  const char* names = nullptr;
  const ElfW(Rela) * slots = nullptr;  // each tells where the address of a function is kept
  std::size_t bytes = 0;               // of slots
  bool has_addends = false;            // the kind of slots that is known here
};

CalledFunctions called_by(const link_map& library) {
  CalledFunctions found{.base = library.l_addr};
  const auto address = [&](const ElfW(Dyn) & entry) {  // some linkers leave them as in the file
    const std::uintptr_t value = entry.d_un.d_ptr;
    return value < found.base ? value + found.base : value;
  };
  // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast,performance-no-int-to-ptr): as it is
  for (const ElfW(Dyn)* entry = library.l_ld; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_SYMTAB)
      found.symbols = reinterpret_cast<const ElfW(Sym)*>(address(*entry));
    if (entry->d_tag == DT_STRTAB)
      found.names = reinterpret_cast<const char*>(address(*entry));
    if (entry->d_tag == DT_JMPREL)
      found.slots = reinterpret_cast<const ElfW(Rela)*>(address(*entry));
    if (entry->d_tag == DT_PLTRELSZ)
      found.bytes = entry->d_un.d_val;
    if (entry->d_tag == DT_PLTREL)
      found.has_addends = entry->d_un.d_val == DT_RELA;
  }
  // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast,performance-no-int-to-ptr)
  return found;
}

/// The function called by that name; null if there is none.
const void* callee(const CalledFunctions& library, std::string_view name) {
  constexpr unsigned kSymbolShift = sizeof(void*) == 8 ? 32 : 8;
  if (!library.symbols || !library.names || !library.slots || !library.has_addends)
    return nullptr;
  for (std::size_t i = 0; i < library.bytes / sizeof(ElfW(Rela)); ++i) {
    const ElfW(Rela)& slot = library.slots[i];
    if (library.names + library.symbols[slot.r_info >> kSymbolShift].st_name == name)
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast,performance-no-int-to-ptr)
      return *reinterpret_cast<const void* const*>(library.base + slot.r_offset);
  }
  return nullptr;
}

}  // namespace

bool is_in_front_of_cyclone(const char* name, const void* function) {
  Dl_info cyclone{};
  void* map = nullptr;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dladdr asks for
  if (dladdr1(reinterpret_cast<void*>(&dds_create_participant), &cyclone, &map, RTLD_DL_LINKMAP) ==
          0 ||
      map == nullptr)
    return false;
  const void* const called = callee(called_by(*static_cast<const link_map*>(map)), name);
  if (called == function || called == nullptr)
    return called != nullptr;
  // In a library that is bound when a function is first called: the function to be found then.
  Dl_info place{};
  const bool is_bound = dladdr(called, &place) == 0 || place.dli_fbase != cyclone.dli_fbase ||
                        called == dlsym(RTLD_NEXT, name);
  return !is_bound && dlsym(RTLD_DEFAULT, name) == function;
}

}  // namespace kinship::dds
