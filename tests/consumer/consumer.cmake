# The user's program, with the components named in CONSUMER_COMPONENTS (any of io, ceres, tbb, mpi).

set(CONSUMER_COMPONENTS "" CACHE STRING "Components of Vernier the program uses")

function(add_consumer)
  add_executable(consumer "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/main.cpp")
  target_link_libraries(consumer PRIVATE vernier::vernier)
  foreach(component IN LISTS CONSUMER_COMPONENTS)
    target_link_libraries(consumer PRIVATE vernier::${component})
    string(TOUPPER ${component} COMPONENT)
    target_compile_definitions(consumer PRIVATE CONSUMER_${COMPONENT})
  endforeach()
endfunction()
