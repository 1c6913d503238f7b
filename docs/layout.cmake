# SPDX-License-Identifier: BSD-3-Clause
# The menu of the site: one entry per folder of pages, with their titles.

# vernier_layout(<output>): writes a Doxygen layout whose menu has the pages of docs/ by kind.
function(vernier_layout output)
  function(entry page indent out)  # a page as a line of the menu
    file(STRINGS "${PROJECT_SOURCE_DIR}/${page}" lines LIMIT_COUNT 10 REGEX "^# ")
    list(GET lines 0 title)
    string(REGEX REPLACE "^# (Tutorial: |Reference: |How to )?" "" title "${title}")
    string(REGEX REPLACE " {#[^}]*}$" "" title "${title}")
    string(SUBSTRING "${title}" 0 1 first)
    string(SUBSTRING "${title}" 1 -1 rest)
    string(TOUPPER "${first}" first)
    string(REGEX MATCH "{#([^}]*)}" label "${lines}")
    if(label)
      set(label "${CMAKE_MATCH_1}")
    else()
      string(REGEX REPLACE "\\.md$" "" label "${page}")
      string(REGEX REPLACE "[^A-Za-z0-9_]" "_" label "page_${label}")
    endif()
    set(${out} "${${out}}${indent}<tab type=\"user\" url=\"@ref ${label}\" title=\"${first}${rest}\"/>\n" PARENT_SCOPE)
  endfunction()

  set(menu)
  entry(docs/guide.md "    " menu)
  foreach(kind tutorials how-to reference explanation algorithms)
    file(GLOB pages CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/docs/${kind}/*.md")
    if(kind STREQUAL "reference")
      list(APPEND pages docs/robot_files.md docs/glossary.md docs/references.md docs/comparison.md)
    elseif(kind STREQUAL "how-to")
      list(APPEND pages docs/your_own.md)
    elseif(kind STREQUAL "algorithms")
      list(PREPEND pages docs/architecture.md CONTRIBUTING.md)
    endif()
    string(SUBSTRING "${kind}" 0 1 first)
    string(SUBSTRING "${kind}" 1 -1 rest)
    string(TOUPPER "${first}" first)
    string(REPLACE "Algorithms" "Developers" title "${first}${rest}")
    string(APPEND menu "    <tab type=\"usergroup\" title=\"${title}\">\n")
    foreach(page IN LISTS pages)
      entry("${page}" "      " menu)
    endforeach()
    string(APPEND menu "    </tab>\n")
  endforeach()
  file(CONFIGURE OUTPUT "${output}" CONTENT "<doxygenlayout version=\"1.0\">
  <navindex>
    <tab type=\"mainpage\" visible=\"yes\" title=\"Vernier\"/>
@menu@    <tab type=\"namespaces\" visible=\"yes\" title=\"Interface\">
      <tab type=\"namespacelist\" visible=\"yes\" title=\"\" intro=\"\"/>
      <tab type=\"namespacemembers\" visible=\"yes\" title=\"\" intro=\"\"/>
      <tab type=\"classlist\" visible=\"yes\" title=\"\" intro=\"\"/>
      <tab type=\"filelist\" visible=\"yes\" title=\"\" intro=\"\"/>
    </tab>
  </navindex>
</doxygenlayout>
" @ONLY)
endfunction()
