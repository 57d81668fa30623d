"""The planar five-bar (5R) of Sosa-López, Arias-Montiel and Lugo-González (2017)."""
