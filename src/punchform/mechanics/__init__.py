"""From node frames to a minimum of the energy: element, kinematics, assembly, factorisation, Newton, descent."""
