//! The FMI 2.0 co-simulation C functions of an urdf2fmu robot.
