# What popcut is built on, for emscripten: Debian's headers where a library is nothing else, and its source packages,
# unpacked in POPCUT_SOURCES, for the rest.
set(CMAKE_UNITY_BUILD OFF)
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)  # options of others, set here
set(CMAKE_WARN_DEPRECATED OFF CACHE BOOL "" FORCE)
set(BUILD_SHARED_LIBS OFF)

# /usr/include as a whole would hide emscripten's own headers.
set(headers ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(path eigen3/Eigen nlohmann tl boost fast_float tiny_gltf.h)
  if(NOT EXISTS /usr/include/${path})
    message(FATAL_ERROR "/usr/include/${path} is missing; use: ./run deps --site")
  endif()
  get_filename_component(name ${path} NAME)
  file(CREATE_LINK /usr/include/${path} ${headers}/${name} SYMBOLIC)
endforeach()
foreach(name Eigen3::Eigen nlohmann_json::nlohmann_json tl::expected Boost::headers fast_float)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${name} INTERFACE ${headers})
endforeach()
foreach(name Threads::Threads PkgConfig::libseccomp)  # there is one thread, and the browser confines it
  add_library(${name} INTERFACE IMPORTED GLOBAL)
endforeach()

# source_of(NAME): the folder of a source package, in source_NAME
function(source_of name)
  file(GLOB found LIST_DIRECTORIES true ${POPCUT_SOURCES}/${name}-[0-9]*)
  list(FILTER found EXCLUDE REGEX "[.](dsc|gz|xz|bz2|asc)$")
  list(LENGTH found count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "POPCUT_SOURCES: ${POPCUT_SOURCES} must hold one folder ${name}-VERSION; use: ./run site")
  endif()
  set(source_${name} ${found} PARENT_SCOPE)
endfunction()
foreach(name fmtlib freetype harfbuzz libjpeg-turbo libpng1.6 libpolyclipping mbedtls muparser nlopt pugixml zlib)
  source_of(${name})
endforeach()

# small_library(TARGET SOURCE-FOLDER HEADER-FOLDER SOURCES ...): one that needs no configuration
function(small_library name folder include)
  list(TRANSFORM ARGN PREPEND ${folder}/)
  add_library(${name} STATIC EXCLUDE_FROM_ALL ${ARGN})
  target_include_directories(${name} SYSTEM PUBLIC ${include})
  target_compile_options(${name} PRIVATE -w)
endfunction()
small_library(fmt ${source_fmtlib}/src ${source_fmtlib}/include format.cc)
small_library(muparser ${source_muparser}/src ${source_muparser}/include
  muParser.cpp muParserBase.cpp muParserBytecode.cpp muParserCallback.cpp muParserError.cpp muParserTokenReader.cpp)
target_compile_definitions(muparser PUBLIC MUPARSER_STATIC)
small_library(pugixml ${source_pugixml}/src ${source_pugixml}/src pugixml.cpp)
small_library(polyclipping ${source_libpolyclipping}/cpp ${headers}/polyclipping clipper.cpp)
file(MAKE_DIRECTORY ${headers}/polyclipping)
file(CREATE_LINK ${source_libpolyclipping}/cpp/clipper.hpp ${headers}/polyclipping/clipper.hpp SYMBOLIC)
small_library(mbedcrypto ${source_mbedtls}/library ${source_mbedtls}/include sha256.c platform_util.c)
small_library(zlib ${source_zlib} ${source_zlib}
  adler32.c compress.c crc32.c deflate.c inffast.c inflate.c inftrees.c trees.c uncompr.c zutil.c)
set(png png.c pngerror.c pngget.c pngmem.c pngpread.c pngread.c pngrio.c pngrtran.c pngrutil.c pngset.c pngtrans.c
        pngwio.c pngwrite.c pngwtran.c pngwutil.c)
small_library(png ${source_libpng1.6} ${headers}/png ${png})
file(MAKE_DIRECTORY ${headers}/png)
foreach(header png.h pngconf.h)
  file(CREATE_LINK ${source_libpng1.6}/${header} ${headers}/png/${header} SYMBOLIC)
endforeach()
file(CREATE_LINK ${source_libpng1.6}/scripts/pnglibconf.h.prebuilt ${headers}/png/pnglibconf.h SYMBOLIC)
target_link_libraries(png PUBLIC zlib)
small_library(harfbuzz ${source_harfbuzz}/src ${source_harfbuzz}/src harfbuzz.cc)
target_compile_definitions(harfbuzz PRIVATE HB_NO_MT)
small_library(tiny_gltf ${CMAKE_CURRENT_SOURCE_DIR} ${headers} tiny_gltf_site.cpp)
target_compile_definitions(tiny_gltf PUBLIC
  TINYGLTF_NO_STB_IMAGE TINYGLTF_NO_STB_IMAGE_WRITE TINYGLTF_NO_EXTERNAL_IMAGE)

# others(TARGET FOLDER): a library by its own CMake; its other targets are not built
function(others name folder)
  add_subdirectory(${folder} ${name} EXCLUDE_FROM_ALL)
  target_compile_options(${name} PRIVATE -w)
endfunction()
foreach(part CXX PYTHON OCTAVE MATLAB GUILE SWIG TESTS)
  set(NLOPT_${part} OFF)
endforeach()
others(nlopt ${source_nlopt})
foreach(part ZLIB BZIP2 PNG HARFBUZZ BROTLI)
  set(FT_DISABLE_${part} ON)
endforeach()
others(freetype ${source_freetype})
# It has a zlib of its own, which knows of no prefix for these.
target_compile_definitions(freetype PRIVATE Z_PREFIX)
foreach(name crc32_combine_gen64 crc32_combine_gen crc32_combine_op z_errmsg zcalloc zcfree)
  target_compile_definitions(freetype PRIVATE ${name}=own_${name})
endforeach()
foreach(type SIZE_T UNSIGNED_LONG)  # its check finds no size in wasm
  set(HAVE_${type} TRUE)
  set(${type} 4)
endforeach()
set(WITH_SIMD OFF)
set(WITH_TURBOJPEG OFF)
set(ENABLE_SHARED OFF)
foreach(folder MANDIR DOCDIR)
  set(CMAKE_INSTALL_${folder} share)  # nothing is installed, but it wants to know where
endforeach()
others(jpeg-static ${source_libjpeg-turbo})
target_include_directories(jpeg-static SYSTEM INTERFACE
  $<BUILD_INTERFACE:${source_libjpeg-turbo}> $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/jpeg-static>)

foreach(alias fmt::fmt=fmt muparser::muparser=muparser pugixml::pugixml=pugixml PkgConfig::polyclipping=polyclipping
        ZLIB::ZLIB=zlib PNG::PNG=png JPEG::JPEG=jpeg-static PkgConfig::harfbuzz=harfbuzz NLopt::nlopt=nlopt
        PkgConfig::freetype=freetype TinyGLTF::TinyGLTF=tiny_gltf)
  string(REGEX MATCH "^(.*)=(.*)$" matched ${alias})
  add_library(${CMAKE_MATCH_1} ALIAS ${CMAKE_MATCH_2})
endforeach()
