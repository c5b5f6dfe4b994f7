# Run with -P at build time: writes into OUT the documents that a package carries beside the program.
#   vernier.1.gz          made from `vernier --help` and each command's, so that it cannot say something else
#   changelog.Debian.gz   Debian's form of the release
#   APP_ID.metainfo.xml   with version and date
# PROGRAM, SOURCE, OUT, PROJECT_VERSION, APP_ID, DATE (seconds since 1970), MAINTAINER
set(ENV{SOURCE_DATE_EPOCH} ${DATE})
string(TIMESTAMP VERNIER_RELEASE_DATE "%Y-%m-%d" UTC)
string(TIMESTAMP rfc_date "%a, %d %b %Y %H:%M:%S +0000" UTC)

function(help_of out)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env COLUMNS=80 ${PROGRAM} ${ARGN} --help
    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

help_of(main)
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE plain COMMAND_ERROR_IS_FATAL ANY)
# The commands stand between this line and the next empty one; examples follow, which look alike.
string(REGEX MATCH "\nSubcommands:(.*)" rest "${plain}")
string(FIND "${CMAKE_MATCH_1}" "\n\n" end)
string(SUBSTRING "${CMAKE_MATCH_1}" 0 ${end} lines)
string(REPLACE ";" "," lines "${lines}")
string(REGEX MATCHALL "\n  [a-z]+ [^\n]*" lines "${lines}")
set(sections "")
foreach(line IN LISTS lines)
  if(line MATCHES "not built yet")
    continue()
  endif()
  string(REGEX REPLACE "\n  ([a-z]+) .*" "\\1" command "${line}")
  help_of(text ${command})
  string(APPEND sections ".SS ${command}\n.nf\n${text}\n.fi\n")
endforeach()
if(sections STREQUAL "")
  message(FATAL_ERROR "No command was found in what `vernier --help` says")
endif()
file(WRITE ${OUT}/vernier.1 ".TH VERNIER 1 \"${VERNIER_RELEASE_DATE}\" \"vernier ${PROJECT_VERSION}\" \"User Commands\"
.SH NAME
vernier \\- review of medical volume images, each picture with its measured error
.SH SYNOPSIS
.B vernier
.I COMMAND
[\\fIOPTION\\fR...]
.SH DESCRIPTION
.nf
${main}
.fi
.SH COMMANDS
${sections}.SH ENVIRONMENT
VERNIER_THREADS, VERNIER_MEMORY_MB, VERNIER_ENGINE and VERNIER_PLUGINS stand for the settings threads, memory_mb,
engine and plugins. VERNIER_GL=off makes Vernier work as if there were no OpenGL.
.SH FILES
.TP
.I $XDG_CONFIG_HOME/vernier/config.json
Settings, a JSON object; \\fBvernier doctor\\fR prints each with where it comes from.
.SH EXIT STATUS
0 done, 1 failed, 2 bad usage, 3 bad input, 4 result out of the tolerance that was asked for.
.SH NOTES
Not a medical device; not for primary diagnosis.
")
file(WRITE ${OUT}/changelog.Debian "vernier (${PROJECT_VERSION}-1) unstable; urgency=medium

  * Release ${PROJECT_VERSION}; what changed stands in changelog.gz.

 -- ${MAINTAINER}  ${rfc_date}
")
configure_file(${SOURCE}/CHANGELOG.md ${OUT}/changelog COPYONLY)
configure_file(${SOURCE}/packaging/desktop/vernier.metainfo.xml ${OUT}/${APP_ID}.metainfo.xml @ONLY)
foreach(file vernier.1 changelog.Debian changelog)
  execute_process(COMMAND gzip -9nf ${OUT}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
